package iiwasim.program;

import com.eclipsesource.json.JsonObject;

import java.math.BigInteger;

/** How a run ended. */
public final class Outcome {
    private final Double startS;
    private final Double endS;
    private final Refusal error;

    private Outcome(Double startS, Double endS, Refusal error) {
        this.startS = startS;
        this.endS = endS;
        this.error = error;
    }

    /** The end of a run whose times nobody knows on FRI's clock. */
    public static Outcome untimed(Refusal error) {
        return new Outcome(null, null, error);
    }

    /** The end of a run by FRI's clock, in s; {@code startS} is null if it did not start. */
    public static Outcome timed(Double startS, Double endS, Refusal error) {
        return new Outcome(startS, endS, error);
    }

    /** Why it was aborted; null if it was not. */
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
