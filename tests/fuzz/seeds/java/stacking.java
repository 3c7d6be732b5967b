package application;

import static com.kuka.roboticsAPI.motionModel.BasicMotions.*;
import javax.inject.Inject;

/** Stacks parts. */
public class Stacking extends RoboticsAPIApplication implements IStation {
    @Inject @Named("Gripper") private Tool gripper;
    private static final double[][] PLACES = {{0.1, -.2e1, (3)}, {}}; // in mm
    private final Map<String, List<Frame>> frames = new HashMap<String, List<Frame>>();
    enum Side { LEFT(1), RIGHT(-1) { int sign() { return -1; } }; final int sign; Side(int sign) { this.sign = sign; } }
    static { System.out.println("\u00e4\n" + 'x'); }

    public Stacking(int count, String... names) { super(count); int n = names.length; }

    @Override public void run() throws Exception {
        gripper.attachTo(lbr.getFlange());
        int i = 0, rows[] = new int[3];
        outer: for (Frame frame : frames.get("ä")) {
            for (int k = 0, m = 2; k < m && !done; k++, --m) {
                if (i % 2 == 0) continue outer; else if ((i) - 1 > 2) break;
                switch (i) { case 1: case 2: gripper.move(lin(frame).setCartVelocity(100)); break; default: }
                switch (i) { case 3, 4 -> stop(); default -> { } }
            }
        }
        do { i += (int) -Math.PI >>> 2; } while (i < 3 ? true : false);
        try (Reader r = open()) { lbr.moveAsync(ptp(0, Math.toRadians(-30), 0)); }
        catch (IOException | RuntimeException e) { throw new IllegalStateException("x", e); }
        finally { synchronized (this) { counter[i]++; } }
        Runnable task = new Runnable() { public void run() { Stacking.this.stop(); } };
        Comparator<Frame> order = (a, b) -> a.getX() < b.getX() ? -1 : 1;
        Object o = o instanceof Frame ? (Frame) o : int[].class; assert o != null : "none";
    }
}
