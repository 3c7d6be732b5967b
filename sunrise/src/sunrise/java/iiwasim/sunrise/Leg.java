package iiwasim.sunrise;

import com.kuka.roboticsAPI.geometricModel.ObjectFrame;
import com.kuka.roboticsAPI.motionModel.RobotMotion;

import java.util.ArrayList;
import java.util.List;

/** Motions of one point of the arm up to a stop, and how long the arm waits there. */
final class Leg {
    /** The point that moves. */
    final ObjectFrame frame;
    /** Batches, one after another without a stop. */
    final List<List<RobotMotion<?>>> batches = new ArrayList<List<RobotMotion<?>>>();
    /** In s. */
    double waitS;

    Leg(ObjectFrame frame) {
        this.frame = frame;
    }

    void add(RobotMotion<?> motion, int batch) {
        if (batches.isEmpty() || batches.get(batches.size() - 1).size() >= batch) {
            batches.add(new ArrayList<RobotMotion<?>>());
        }
        batches.get(batches.size() - 1).add(motion);
    }
}
