package iiwasim.program;

import com.eclipsesource.json.Json;
import com.eclipsesource.json.JsonArray;
import com.eclipsesource.json.JsonObject;

import java.math.BigInteger;
import java.util.List;

/**
 * The robot program without its sockets: instructions are the input, acknowledgements and states
 * the output, all as text.
 *
 * <p>One thread gives instructions, others read the state and report the ends of runs.
 */
public final class Program {
    /** The version of the protocol. */
    public static final int PROTOCOL = 1;

    /** The version of this program. */
    public static final String VERSION = "iiwasim 0.1.0";

    /**
     * Maximum time from planning to the begin of motions, as the drive or its client may be gone.
     */
    private static final long BEGIN_WITHIN_NS = 2000000000L;

    /** Clock with the time in ns since any fixed instant. */
    public interface Clock {
        long nanoTime();
    }

    private enum State {
        IDLE("idle"), RUNNING_MOTION("running_motion"), RUNNING_TRAJECTORY("running_trajectory");

        private final String text;

        State(String text) {
            this.text = text;
        }
    }

    private final Backend backend;
    private final long boot;
    private final Clock clock;

    private Backend.Plan plan;
    private BigInteger planned;
    private long plannedAt;

    // Shared by threads: guarded by `this`.
    private State state = State.IDLE;
    private BigInteger run;
    private BigInteger endedRun;
    private Outcome outcome;
    private long changes;

    /**
     * A program without instructions so far.
     *
     * @param boot a number that differs with each start
     */
    public Program(Backend backend, long boot, Clock clock) {
        this.backend = backend;
        this.boot = boot;
        this.clock = clock;
    }

    /** Executes an instruction of several frames, and returns the acknowledgement. */
    public String instruct(List<String> frames) {
        if (frames.size() != 1) {
            return refused(null, Refusal.bad("an instruction has to consist of one frame"));
        }
        return instruct(frames.get(0));
    }

    /** Executes an instruction, null for invalid text, and returns the acknowledgement. */
    public String instruct(String text) {
        BigInteger seq = null;
        try {
            if (text == null) {
                throw Refusal.bad("the instruction is not text in UTF-8");
            }
            Instruction.Head head = Instruction.head(text);
            seq = head.seq;
            JsonObject answer = new JsonObject().add("seq", Keys.number(seq));
            carryOut(Instruction.read(head), answer);
            return answer.toString();
        } catch (Refusal refusal) {
            return refused(seq, refusal);
        } catch (RuntimeException error) {
            // An exception of the controller must not end the program, which brings the robot to a
            // stop.
            return refused(
                seq, Refusal.robot("the robot program has failed: " + Messages.of(error)));
        }
    }

    private void carryOut(Instruction instruction, JsonObject answer) throws Refusal {
        if (plan != null && clock.nanoTime() - plannedAt > BEGIN_WITHIN_NS) {
            plan = null;
        }
        switch (instruction.type) {
            case RUN_MOTIONS:
                checkReady();
                plan = null;
                Backend.Plan made = backend.plan(instruction.motions);
                planned = instruction.run;
                plannedAt = clock.nanoTime();
                plan = made;
                break;
            case BEGIN:
                begin(instruction.run);
                break;
            case RUN_TRAJECTORY:
                checkReady();
                begin(State.RUNNING_TRAJECTORY, instruction.run, new Backend.Plan() {
                    @Override
                    public void begin(Backend.Listener listener) throws Refusal {
                        backend.beginCommanding(listener);
                    }
                });
                break;
            case END_TRAJECTORY:
                if (runs(State.RUNNING_TRAJECTORY, instruction.run)) {
                    backend.endCommanding();
                }
                break;
            case STOP:
                plan = null;
                if (!isIdle()) {
                    backend.stop();
                }
                break;
            case READ_SENSORS:
                answer.add("sensors", backend.sensors().json());
                break;
            case LIST_IO:
                JsonArray signals = new JsonArray();
                for (Signal signal : backend.signals()) {
                    signals.add(signal.json());
                }
                answer.add("io", signals);
                break;
            case GET_IO:
                answer.add("value", backend.get(instruction.name).json());
                break;
            default:
                answer.add("value", backend.set(instruction.name, instruction.value).json());
        }
    }

    private void begin(BigInteger wanted) throws Refusal {
        Backend.Plan ready = plan != null && planned.equals(wanted) ? plan : null;
        if (ready == null) {
            throw Refusal.robot("these motions are not planned, or their plan has expired");
        }
        plan = null;
        checkReady();
        begin(State.RUNNING_MOTION, wanted, ready);
    }

    /**
     * Begins a run. The lock hides intermediate states: a refusal by the robot, or an immediate
     * end, is published as one change.
     */
    private synchronized void begin(State kind, BigInteger started, Backend.Plan what)
        throws Refusal {
        state = kind;
        run = started;
        boolean isBegun = false;
        try {
            what.begin(new End(started));
            changes++;
            isBegun = true;
        } finally {
            if (!isBegun) {
                state = State.IDLE;
                run = null;
            }
        }
    }

    private void checkReady() throws Refusal {
        if (!isIdle()) {
            throw new Refusal(Refusal.Code.NOT_IDLE, "the robot is busy with another run");
        }
        backend.checkReady();
    }

    private synchronized boolean isIdle() {
        return state == State.IDLE;
    }

    private synchronized boolean runs(State kind, BigInteger wanted) {
        return state == kind && wanted.equals(run);
    }

    /** The end of a run. */
    private final class End implements Backend.Listener {
        private final BigInteger of;

        End(BigInteger of) {
            this.of = of;
        }

        @Override
        public void ended(Outcome how) {
            synchronized (Program.this) {
                if (state == State.IDLE || !of.equals(run)) {
                    return;
                }
                state = State.IDLE;
                run = null;
                endedRun = of;
                outcome = how;
                changes++;
            }
        }
    }

    /** Number of state changes. */
    public synchronized long changes() {
        return changes;
    }

    /** The state message for the drive. */
    public String state() {
        Conditions conditions = backend.conditions();
        String sunrise = backend.sunriseVersion();
        JsonObject hello = new JsonObject().add("protocol", PROTOCOL).add("program", VERSION);
        if (sunrise != null) {
            hello.add("sunrise", sunrise);
        }
        if (backend.robot() != null) {
            hello.add("robot", backend.robot().json());
        }
        synchronized (this) {
            JsonObject json = new JsonObject().add("boot", boot).add("state", state.text);
            if (run != null) {
                json.add("run", Keys.number(run));
            }
            if (outcome != null) {
                json.add("outcome", outcome.json(endedRun));
            }
            if (backend.isSimulated()) {
                json.add("simulated", true);
            }
            if (conditions != null) {
                json.add("conditions", conditions.json());
            }
            return json.add("hello", hello).toString();
        }
    }

    private static String refused(BigInteger seq, Refusal refusal) {
        return new JsonObject().add("seq", seq == null ? Json.NULL : Keys.number(seq))
            .add("error", json(refusal))
            .toString();
    }

    static JsonObject json(Refusal refusal) {
        return new JsonObject().add("code", refusal.code().text())
            .add("message", refusal.getMessage());
    }
}
