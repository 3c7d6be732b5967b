package iiwasim.sunrise;

import com.kuka.roboticsAPI.geometricModel.ObjectFrame;
import com.kuka.roboticsAPI.motionModel.RobotMotion;

import java.util.ArrayList;
import java.util.List;

/** Motions with one TCP up to a stop, and the waiting time there. */
final class Leg {
    /** TCP of the motions. */
    final ObjectFrame frame;
    /** Batches, one after another without a stop. */
    final List<List<RobotMotion<?>>> batches = new ArrayList<List<RobotMotion<?>>>();
    /** Waiting time, in s. */
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
