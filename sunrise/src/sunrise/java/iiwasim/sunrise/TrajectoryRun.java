package iiwasim.sunrise;

import com.kuka.roboticsAPI.deviceModel.JointPosition;
import com.kuka.roboticsAPI.deviceModel.LBR;
import com.kuka.roboticsAPI.motionModel.PositionHold;
import com.kuka.roboticsAPI.motionModel.controlModeModel.PositionControlMode;

import iiwasim.program.Backend;
import iiwasim.program.Refusal;

import java.util.concurrent.TimeUnit;

/**
 * A trajectory with set-points over FRI: the controller holds its position, with FRI as an overlay.
 * The hold lasts only as long as the trajectory, so that the brakes close between trajectories.
 */
final class TrajectoryRun extends Run {
    /** Maximum time for the session to become active. */
    private static final long ACTIVE_MS = 5000;
    private static final long LOOK_MS = 100;

    /** Interval of two position readings, which detect standstill. */
    private static final long REST_MS = 50;
    private static final double REST_RAD = 5e-4;

    private final LBR robot;
    private final FriKeeper fri;
    private boolean isFinished;

    TrajectoryRun(LBR robot, FriKeeper fri, Backend.Listener listener) {
        super(listener, "iiwasim trajectory");
        this.robot = robot;
        this.fri = fri;
    }

    @Override
    void start() {
        PositionHold hold = new PositionHold(new PositionControlMode(), -1, TimeUnit.SECONDS);
        add(robot.moveAsync(hold.addMotionOverlay(fri.overlay()), waker()));
    }

    @Override
    void proceed() throws Refusal, InterruptedException {
        long until = System.nanoTime() + ACTIVE_MS * 1000000;
        boolean wasActive = false;
        while (!isFinished()) {
            check();
            boolean isActive = fri.isActive();
            if (!isActive && wasActive) {
                throw Refusal.robot("FRI has left active commanding: " + fri.state());
            }
            if (!isActive && System.nanoTime() > until) {
                throw Refusal.robot(
                    "FRI did not become active within " + ACTIVE_MS / 1000 + " s: " + fri.state());
            }
            wasActive |= isActive;
            pause(LOOK_MS);
        }
        if (isMoving()) {
            throw Refusal.robot("the trajectory was ended while the arm moved");
        }
    }

    private boolean isMoving() throws InterruptedException {
        JointPosition before = robot.getCurrentJointPosition();
        Thread.sleep(REST_MS);
        JointPosition after = robot.getCurrentJointPosition();
        for (int j = 0; j < 7; j++) {
            if (Math.abs(after.get(j) - before.get(j)) > REST_RAD) {
                return true;
            }
        }
        return false;
    }

    /** Ends the trajectory after the last set-point of the drive. */
    synchronized void finish() {
        isFinished = true;
        notifyAll();
    }

    private synchronized boolean isFinished() {
        return isFinished;
    }
}
