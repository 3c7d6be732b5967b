package iiwasim.program;

import java.util.List;

/**
 * Interface to the robot: the Sunrise controller, or a simulation of it.
 *
 * <p>All calls are from one thread, except for {@link #conditions()}. No call takes longer than
 * planning.
 */
public interface Backend {
    /** Receives the end of a run, once, from any thread. */
    interface Listener {
        void ended(Outcome outcome);
    }

    /** Planned motions that are ready to begin. */
    interface Plan {
        /** Begins the motions. */
        void begin(Listener listener) throws Refusal;
    }

    /** Fails if a run cannot begin now: a safety stop is active, or the robot is not ready. */
    void checkReady() throws Refusal;

    /** Plans motions from the current position. */
    Plan plan(MotionList motions) throws Refusal;

    /** Enables commanding over FRI. */
    void beginCommanding(Listener listener) throws Refusal;

    /** Ends commanding over FRI; the run then ends. */
    void endCommanding() throws Refusal;

    /** Stops the current run, which then ends with an error. */
    void stop() throws Refusal;

    Sensors sensors() throws Refusal;

    /** All inputs and outputs. */
    List<Signal> signals() throws Refusal;

    SignalValue get(String name) throws Refusal;

    /** Sets an output and returns its new value. */
    SignalValue set(String name, SignalValue value) throws Refusal;

    /** The last observed conditions; never waits for the controller. */
    Conditions conditions();

    /** True if the robot is simulated, so that nobody is near it. */
    boolean isSimulated();

    /** Sunrise version; null if unknown. */
    String sunriseVersion();

    /** Identity of the robot; null if unknown. */
    RobotIdentity robot();

    /** Ends the current run, and frees all resources. */
    void close();
}
