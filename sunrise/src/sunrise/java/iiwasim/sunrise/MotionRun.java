package iiwasim.sunrise;

import com.kuka.roboticsAPI.motionModel.MotionBatch;
import com.kuka.roboticsAPI.motionModel.RobotMotion;

import iiwasim.program.Backend;
import iiwasim.program.Refusal;

import java.util.List;

/** A run of motions that the controller plans. */
final class MotionRun extends Run {
    private final List<Leg> legs;

    MotionRun(List<Leg> legs, Backend.Listener listener) {
        super(listener, "iiwasim motions");
        this.legs = legs;
    }

    @Override
    void start() {
        send(legs.get(0));
    }

    @Override
    void proceed() throws Refusal, InterruptedException {
        for (int i = 0; i < legs.size(); i++) {
            check();
            if (i > 0) {
                send(legs.get(i));
            }
            awaitContainers();
            rest(legs.get(i).waitS);
        }
    }

    /**
     * Sends the batches of a leg. The robot does not stop between batches if the last motion is
     * blended.
     */
    private void send(Leg leg) {
        for (List<RobotMotion<?>> motions : leg.batches) {
            MotionBatch batch =
                new MotionBatch(motions.toArray(new RobotMotion<?>[motions.size()]));
            add(leg.frame.moveAsync(batch, waker()));
        }
    }

    private void rest(double seconds) throws Refusal, InterruptedException {
        long until = System.nanoTime() + (long) (seconds * 1e9);
        for (long left = until - System.nanoTime(); left > 0; left = until - System.nanoTime()) {
            pause(Math.max(1, left / 1000000));
            check();
        }
    }
}
