package iiwasim.sunrise;

import com.kuka.roboticsAPI.applicationModel.IApplicationControl;
import com.kuka.roboticsAPI.applicationModel.IApplicationData;
import com.kuka.roboticsAPI.controllerModel.sunrise.SunriseSafetyState.SafetyStopType;
import com.kuka.roboticsAPI.deviceModel.Device;
import com.kuka.roboticsAPI.deviceModel.LBR;
import com.kuka.roboticsAPI.geometricModel.Tool;
import com.kuka.roboticsAPI.motionModel.ErrorHandlingAction;
import com.kuka.roboticsAPI.motionModel.IErrorHandler;
import com.kuka.roboticsAPI.motionModel.IMotionContainer;

import iiwasim.program.Backend;
import iiwasim.program.Conditions;
import iiwasim.program.Log;
import iiwasim.program.Messages;
import iiwasim.program.MotionList;
import iiwasim.program.Refusal;
import iiwasim.program.RobotIdentity;
import iiwasim.program.Sensors;
import iiwasim.program.Server;
import iiwasim.program.Settings;
import iiwasim.program.Signal;
import iiwasim.program.SignalValue;

import java.util.List;

/** The robot, controlled through KUKA's RoboticsAPI. */
final class SunriseBackend implements Backend {
    private final LBR robot;
    private final Settings settings;
    private final RobotWatch watch;
    private final MotionMapping mapping;
    private final IoGroups io;
    private final FriKeeper fri;
    private Run run;
    /** True while the program ends: runs cannot begin any more. */
    private boolean isEnding;

    SunriseBackend(
        LBR robot, IApplicationControl control, IApplicationData data, Settings settings, Log log) {
        this.robot = robot;
        this.settings = settings;
        Tool tool = null;
        if (settings.tool() != null) {
            tool = data.createFromTemplate(settings.tool());
            tool.attachTo(robot.getFlange());
        }
        mapping = new MotionMapping(robot, tool, settings.tool());
        io = new IoGroups(robot.getController(), settings.signals());
        fri = new FriKeeper(robot, settings, log);
        control.registerMoveAsyncErrorHandler(new IErrorHandler() {
            @Override
            public ErrorHandlingAction handleError(
                Device device, IMotionContainer failed, List<IMotionContainer> canceled) {
                abort(failed.getErrorMessage() == null ? "the controller has aborted a motion"
                    : failed.getErrorMessage());
                // Ending the program would close the connection that reports the reason.
                return ErrorHandlingAction.Ignore;
            }
        });
        watch = new RobotWatch(robot, control, settings.tool(), new RobotWatch.Listener() {
            @Override
            public void stopped(String why) {
                abort(why);
            }
        });
        watch.start();
    }

    /** Opens FRI; the client may be the connected drive. */
    void openFri(Server server) {
        fri.start(server);
    }

    /** Aborts the current run, for a reason that people can read. */
    void abort(String why) {
        Run current = current();
        if (current != null) {
            current.abort(Refusal.robot(why));
        }
    }

    private synchronized Run current() {
        return run;
    }

    private synchronized void set(Run next) throws Refusal {
        if (isEnding) {
            throw Refusal.robot("the robot program is ending");
        }
        run = next;
    }

    /**
     * Aborts the current run, and refuses further runs; the drive is served until the ports close.
     */
    void end(String why) {
        synchronized (this) {
            isEnding = true;
        }
        abort(why);
    }

    @Override
    public void checkReady() throws Refusal {
        SafetyStopType stop = robot.getSafetyState().getSafetyStopSignal();
        if (stop != SafetyStopType.NOSTOP) {
            throw Refusal.robot("a safety stop is active (" + stop
                + "): emergency stop, protective stop or enabling switch");
        }
        if (!robot.isMastered()) {
            throw Refusal.robot("not all axes are mastered");
        }
        if (watch.isPaused()) {
            throw Refusal.robot("the robot program is paused on the smartPAD: press its start key");
        }
        if (!robot.isReadyToMove()) {
            throw Refusal.robot("the robot is not ready to move: in T1 and T2 hold the enabling "
                + "switch and the start key;"
                + " the smartPAD tells more");
        }
        Run current = current();
        if (current != null && !current.hasEnded()) {
            throw new Refusal(Refusal.Code.NOT_IDLE, "the arm is still coming to rest");
        }
    }

    @Override
    public Plan plan(MotionList motions) throws Refusal {
        final List<Leg> legs = mapping.legs(motions, settings.batch());
        return new Plan() {
            @Override
            public void begin(Listener listener) throws Refusal {
                Run next = new MotionRun(legs, listener);
                set(next);
                next.begin();
            }
        };
    }

    @Override
    public void beginCommanding(Listener listener) throws Refusal {
        fri.checkReady();
        Run next = new TrajectoryRun(robot, fri, listener);
        set(next);
        next.begin();
    }

    @Override
    public void endCommanding() {
        Run current = current();
        if (current instanceof TrajectoryRun) {
            ((TrajectoryRun) current).finish();
        }
    }

    @Override
    public void stop() {
        abort("stopped on request");
    }

    @Override
    public Sensors sensors() {
        // A call for temperatures is not known.
        return new Sensors(null, robot.getExternalTorque().getTorqueValues());
    }

    @Override
    public List<Signal> signals() throws Refusal {
        return io.all();
    }

    @Override
    public SignalValue get(String name) throws Refusal {
        return io.get(name);
    }

    @Override
    public SignalValue set(String name, SignalValue value) throws Refusal {
        return io.set(name, value);
    }

    @Override
    public Conditions conditions() {
        return watch.conditions();
    }

    @Override
    public boolean isSimulated() {
        return false;
    }

    @Override
    public String sunriseVersion() {
        return settings.sunrise();
    }

    @Override
    public RobotIdentity robot() {
        return settings.robot();
    }

    @Override
    public void close() {
        try {
            end("the robot program has ended");
            Run current = current();
            if (current != null) {
                current.awaitEnd();
            }
        } finally {
            watch.close();
            fri.close();
        }
    }

    /** A refusal from the exception of a command that the controller rejects. */
    static Refusal refused(RuntimeException error) {
        return Refusal.robot("the controller refuses: " + Messages.of(error));
    }
}
