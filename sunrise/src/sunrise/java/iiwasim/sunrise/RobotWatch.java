package iiwasim.sunrise;

import com.kuka.roboticsAPI.applicationModel.IApplicationControl;
import com.kuka.roboticsAPI.controllerModel.sunrise.SunriseExecutionService;
import com.kuka.roboticsAPI.controllerModel.sunrise.SunriseSafetyState.SafetyStopType;
import com.kuka.roboticsAPI.deviceModel.LBR;

import iiwasim.program.Conditions;

import java.util.Locale;

/**
 * Polls the conditions of the robot at 5 Hz: above 10 Hz, the interface of the controller breaks
 * down. The polling does not stop the robot; it prevents a stopped run from continuing.
 */
final class RobotWatch {
    /** Receives stops. */
    interface Listener {
        void stopped(String why);
    }

    private static final long EVERY_MS = 200;

    private final LBR robot;
    private final IApplicationControl control;
    private final String tool;
    private final Listener listener;
    private final Thread thread;
    private volatile boolean isClosing;
    private volatile boolean isPaused;
    private volatile Conditions conditions;

    RobotWatch(LBR robot, IApplicationControl control, String tool, Listener listener) {
        this.robot = robot;
        this.control = control;
        this.tool = tool;
        this.listener = listener;
        thread = new Thread(new Runnable() {
            @Override
            public void run() {
                watch();
            }
        }, "iiwasim watch");
        thread.setDaemon(true);
    }

    void start() {
        thread.start();
    }

    /** The last polled conditions; null before the first poll. */
    Conditions conditions() {
        return conditions;
    }

    /** True if the execution of motions is paused. */
    boolean isPaused() {
        return isPaused;
    }

    private void watch() {
        while (!isClosing) {
            try {
                look();
            } catch (RuntimeException error) {
                conditions = null;
                listener.stopped("the state of the robot cannot be read: " + error.getMessage());
            }
            try {
                Thread.sleep(EVERY_MS);
            } catch (InterruptedException interrupt) {
                return;
            }
        }
    }

    private void look() {
        SafetyStopType stop = robot.getSafetyState().getSafetyStopSignal();
        boolean isStopped = stop != SafetyStopType.NOSTOP;
        String mode = robot.getOperationMode().name().toLowerCase(Locale.ROOT);
        conditions = new Conditions(mode, control.getApplicationOverride(), isStopped, tool);
        isPaused = ((SunriseExecutionService) robot.getController().getExecutionService())
            .isPaused();
        if (isStopped) {
            listener.stopped("a safety stop has become active (" + stop
                + "); a run does not go on after a stop");
        } else if (isPaused) {
            listener.stopped("the motion was paused; a run does not go on after a pause");
        }
    }

    void close() {
        isClosing = true;
        thread.interrupt();
        Run.join(thread);
    }
}
