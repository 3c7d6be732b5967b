package iiwasim.program;

import com.eclipsesource.json.JsonValue;

import java.math.BigInteger;
import java.util.Locale;

/** An instruction of the drive. */
final class Instruction {
    enum Type { RUN_MOTIONS, BEGIN, RUN_TRAJECTORY, END_TRAJECTORY, STOP, READ_SENSORS, LIST_IO,
        GET_IO, SET_IO }

    final Type type;
    /** Number of the run; null without a run. */
    final BigInteger run;
    final MotionList motions;
    /** The name of a signal. */
    final String name;
    /** A value to set. */
    final SignalValue value;

    private Instruction(
        Type type, BigInteger run, MotionList motions, String name, SignalValue value) {
        this.type = type;
        this.run = run;
        this.motions = motions;
        this.name = name;
        this.value = value;
    }

    /** Header of an instruction: the keys of the object, its number and its type. */
    static final class Head {
        final JsonValue json;
        final Keys keys;
        final BigInteger seq;
        final String type;

        private Head(JsonValue json) throws Refusal {
            this.json = json;
            keys = new Keys(json, "");
            seq = keys.whole("seq");
            type = keys.text("type");
        }
    }

    /** Reads number and type, which error messages about the instruction need. */
    static Head head(String text) throws Refusal {
        return new Head(Keys.parse(text));
    }

    /** Reads the content. */
    static Instruction read(Head head) throws Refusal {
        Keys keys = head.keys;
        for (Type type : Type.values()) {
            if (!type.name().toLowerCase(Locale.ROOT).equals(head.type)) {
                continue;
            }
            switch (type) {
                case RUN_MOTIONS:
                    MotionList motions = MotionReader.read(keys, head.json);
                    BigInteger run = keys.whole("run");
                    keys.refuseOthers();
                    return new Instruction(type, run, motions, null, null);
                case BEGIN:
                case RUN_TRAJECTORY:
                case END_TRAJECTORY:
                    return new Instruction(type, keys.whole("run"), null, null, null);
                case GET_IO:
                    return new Instruction(type, null, null, keys.text("name"), null);
                case SET_IO:
                    return new Instruction(
                        type, null, null, keys.text("name"), SignalValue.read(keys, "value"));
                default:
                    return new Instruction(type, null, null, null, null);
            }
        }
        throw Refusal.bad("unknown instruction `" + Messages.excerpt(head.type) + "`");
    }
}
