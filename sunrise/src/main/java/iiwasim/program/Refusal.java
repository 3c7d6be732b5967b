package iiwasim.program;

/** Reason for the refusal of an instruction, or for the failure of a run. */
public final class Refusal extends Exception {
    private static final long serialVersionUID = 1L;

    /** The codes of the protocol. */
    public enum Code {
        /** The instruction is malformed, or names something that does not exist. */
        BAD_REQUEST("bad_request"),
        /** Another run is active. */
        NOT_IDLE("not_idle"),
        /** A limit of the robot would be exceeded. */
        LIMIT("limit"),
        /** The robot is not ready, or has stopped. */
        ROBOT("robot"),
        /** A deadline has passed. */
        TIMEOUT("timeout");

        private final String text;

        Code(String text) {
            this.text = text;
        }

        /** The code in messages. */
        public String text() {
            return text;
        }

        /** The code with this text; {@link #ROBOT} for an unknown text. */
        public static Code of(String text) {
            for (Code code : values()) {
                if (code.text.equals(text)) {
                    return code;
                }
            }
            return ROBOT;
        }
    }

    private final Code code;

    public Refusal(Code code, String message) {
        super(Messages.line(message));
        this.code = code;
    }

    /** A refusal of a malformed instruction, or of a name that does not exist. */
    public static Refusal bad(String message) {
        return new Refusal(Code.BAD_REQUEST, message);
    }

    /** A refusal because of the robot's condition. */
    public static Refusal robot(String message) {
        return new Refusal(Code.ROBOT, message);
    }

    public Code code() {
        return code;
    }

    /** Does nothing, as nobody reads the stack trace, and filling it in takes time. */
    @Override
    public synchronized Throwable fillInStackTrace() {
        return this;
    }
}
