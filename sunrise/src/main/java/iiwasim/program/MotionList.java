package iiwasim.program;

import com.eclipsesource.json.JsonObject;

import java.util.Collections;
import java.util.List;

/** Motions of an instruction, in order. */
public final class MotionList {
    private final List<Motion> motions;
    private final boolean isT1;
    private final JsonObject source;

    MotionList(List<Motion> motions, boolean isT1, JsonObject source) {
        this.motions = Collections.unmodifiableList(motions);
        this.isT1 = isT1;
        this.source = source;
    }

    public List<Motion> motions() {
        return motions;
    }

    /** True if TCP and flange have to move slowly, as in the operation mode T1. */
    public boolean isT1() {
        return isT1;
    }

    /** The instruction with the motions. */
    public JsonObject source() {
        return source;
    }
}
