package iiwasim.program;

import com.eclipsesource.json.JsonObject;

import java.math.BigInteger;

/** Outcome of a run. */
public final class Outcome {
    private final Double startS;
    private final Double endS;
    private final Refusal error;

    private Outcome(Double startS, Double endS, Refusal error) {
        this.startS = startS;
        this.endS = endS;
        this.error = error;
    }

    /** The end of a run whose times on the FRI clock are unknown. */
    public static Outcome untimed(Refusal error) {
        return new Outcome(null, null, error);
    }

    /** The end of a run by the FRI clock, in s; {@code startS} is null if the run did not start. */
    public static Outcome timed(Double startS, Double endS, Refusal error) {
        return new Outcome(startS, endS, error);
    }

    /** Reason for an abort; null without an abort. */
    public Refusal error() {
        return error;
    }

    JsonObject json(BigInteger run) {
        JsonObject json = new JsonObject().add("run", Keys.number(run));
        if (startS != null) {
            json.add("start_s", startS.doubleValue());
        }
        if (endS != null) {
            json.add("end_s", endS.doubleValue());
        }
        if (error != null) {
            json.add("error", Program.json(error));
        }
        return json;
    }
}
