package iiwasim.program;

import static org.junit.Assert.assertArrayEquals;
import static org.junit.Assert.assertEquals;

import org.junit.Test;

import java.util.Random;

public class PoseTest {
    @Test
    public void anglesAreThoseThatItIsMadeOf() {
        Random random = new Random(1);
        for (int i = 0; i < 1000; i++) {
            double a = 6 * random.nextDouble() - 3;
            double b = 3 * random.nextDouble() - 1.5;
            double c = 6 * random.nextDouble() - 3;
            assertArrayEquals(new double[] {a, b, c}, Pose.of(1, 2, 3, a, b, c).abcRad(), 1e-9);
        }
        Pose upright = Pose.of(0, 0, 0, 0.3, Math.PI / 2, 0.2);
        double[] abc = upright.abcRad();
        assertEquals(0, upright.angleRad(Pose.of(0, 0, 0, abc[0], abc[1], abc[2])), 1e-9);
    }

    @Test
    public void anInverseUndoesIt() {
        Pose pose = Pose.of(10, -20, 30, 0.5, -0.3, 2);
        Pose back = pose.then(pose.inverse());
        assertEquals(0, back.distanceMm(Pose.IDENTITY), 1e-9);
        assertEquals(0, back.angleRad(Pose.IDENTITY), 1e-9);
        assertEquals(0.25, pose.angleRad(pose.then(Pose.of(0, 0, 0, 0, 0, 0.25))), 1e-9);
        // The TCP of a gripper that points down.
        Pose down = Pose.of(500, 0, 400, 0, Math.PI, 0).then(Pose.of(0, 0, 120, 0, 0, 0));
        assertArrayEquals(new double[] {500, 0, 280}, down.xyzMm(), 1e-9);
    }
}
