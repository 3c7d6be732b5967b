package iiwasim.program;

import com.eclipsesource.json.JsonObject;

import java.util.Collection;

/** An input or output with its value. */
public final class Signal {
    private final String name;
    private final boolean isOutput;
    private final SignalValue value;

    public Signal(String name, boolean isOutput, SignalValue value) {
        this.name = name;
        this.isOutput = isOutput;
        this.value = value;
    }

    public String name() {
        return name;
    }

    public boolean isOutput() {
        return isOutput;
    }

    public SignalValue value() {
        return value;
    }

    /** The signal with a name. */
    public static Signal find(Collection<Signal> signals, String name) throws Refusal {
        StringBuilder known = new StringBuilder();
        for (Signal signal : signals) {
            if (signal.name.equals(name)) {
                return signal;
            }
            known.append(known.length() == 0 ? "" : ", ").append(signal.name);
        }
        throw Refusal.bad(
            "unknown input or output `" + Messages.excerpt(name) + "`; known names are "
            + (known.length() == 0 ? "none" : known));
    }

    /** Converts a value to the type of this output. */
    public SignalValue fitting(SignalValue wanted) throws Refusal {
        if (!isOutput) {
            throw Refusal.bad(name + " is an input; it cannot be set");
        }
        if (value.truth() != null) {
            if (wanted.truth() == null) {
                throw Refusal.bad(name + " takes true or false, not " + wanted);
            }
            return wanted;
        }
        if (value.whole() != null) {
            if (wanted.whole() == null) {
                throw Refusal.bad(name + " takes a whole number, not " + wanted);
            }
            return wanted;
        }
        if (wanted.truth() != null) {
            throw Refusal.bad(name + " takes a number, not " + wanted);
        }
        return SignalValue.of(wanted.number());
    }

    JsonObject json() {
        return new JsonObject().add("name", name).add("direction", isOutput ? "output" : "input")
            .add("value", value.json());
    }
}
