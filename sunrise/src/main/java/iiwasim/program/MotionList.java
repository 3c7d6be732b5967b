package iiwasim.program;

import com.eclipsesource.json.JsonObject;

import java.util.Collections;
import java.util.List;

/** Motions in order, as an instruction gives them. */
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

    /** Whether TCP and flange are to move slowly, as in the mode T1. */
    public boolean isT1() {
        return isT1;
    }

    /** The instruction that gave them. */
    public JsonObject source() {
        return source;
    }
}
