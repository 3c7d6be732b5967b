package iiwasim.program;

import java.util.List;

/**
 * What moves the robot: the Sunrise controller, or something that stands for it.
 *
 * <p>One thread calls it, except for {@link #conditions()}. No call takes longer than planning does.
 */
public interface Backend {
    /** Hears the end of a run, once, from any thread. */
    interface Listener {
        void ended(Outcome outcome);
    }

    /** Motions that are planned and can begin. */
    interface Plan {
        /** Begins them. */
        void begin(Listener listener) throws Refusal;
    }

    /** Fails if no run may begin now: a safety stop is active, or the robot is not ready. */
    void checkReady() throws Refusal;

    /** Plans motions from where the arm is. */
    Plan plan(MotionList motions) throws Refusal;

    /** Enables commanding over FRI. */
    void beginCommanding(Listener listener) throws Refusal;

    /** Ends commanding over FRI; the run then ends. */
    void endCommanding() throws Refusal;

    /** Stops what runs; the run then ends with an error. */
    void stop() throws Refusal;

    Sensors sensors() throws Refusal;

    /** All inputs and outputs. */
    List<Signal> signals() throws Refusal;

    SignalValue get(String name) throws Refusal;

    /** Sets an output and returns its new value. */
    SignalValue set(String name, SignalValue value) throws Refusal;

    /** The conditions, as last seen: it never waits for the controller. */
    Conditions conditions();

    /** Whether the robot is simulated, so that nobody is near it. */
    boolean isSimulated();

    /** The version of Sunrise; null if it is not known. */
    String sunriseVersion();

    /** The robot; null if it is not known. */
    RobotIdentity robot();

    /** Ends what runs, and frees everything. */
    void close();
}
