package application;

import static com.kuka.roboticsAPI.motionModel.BasicMotions.lin;
import static com.kuka.roboticsAPI.motionModel.BasicMotions.linRel;
import static com.kuka.roboticsAPI.motionModel.BasicMotions.ptp;
import static com.kuka.roboticsAPI.motionModel.BasicMotions.spl;

import com.kuka.common.ThreadUtil;
import com.kuka.generated.ioAccess.VacuumIOGroup;
import com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplication;
import com.kuka.roboticsAPI.deviceModel.JointPosition;
import com.kuka.roboticsAPI.deviceModel.LBR;
import com.kuka.roboticsAPI.geometricModel.Frame;
import com.kuka.roboticsAPI.geometricModel.Tool;
import java.util.ArrayList;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import javax.inject.Inject;
import javax.inject.Named;

/** Takes parts out of boxes of 4 by 3 places, and counts them. */
public class Large extends RoboticsAPIApplication {
    private static final int BOXES = 10;
    private static final int PLACES = 12;
    private static final double LIFT = 60;
    private static final JointPosition READY =
        new JointPosition(0, Math.toRadians(30), 0, Math.toRadians(-85), 0, Math.toRadians(65), 0);

    private enum Mode { FAST, SLOW }

    @Inject private LBR lbr;
    @Inject @Named("SuctionCups") private Tool cups;
    @Inject private VacuumIOGroup vacuum;

    private final List<String> log = new ArrayList<String>();
    private final Map<String, Integer> counts = new HashMap<String, Integer>();
    private Mode mode = Mode.FAST;

    @Override
    public void initialize() {
        cups.attachTo(lbr.getFlange());
    }

    @Override
    public void run() {
        lbr.move(ptp(READY).setJointVelocityRel(0.6));
        for (int box = 0; box < BOXES; box++) {
            int number = 0;
            for (Frame place : places(18 + box % 5)) {
                work(place, number++);
                note("box " + box, number, place);
            }
            getLogger().info(log.get(log.size() - 1));
        }
        lbr.move(ptp(READY).setJointVelocityRel(0.6));
    }

    private List<Frame> places(double pitch) {
        List<Frame> all = new ArrayList<Frame>();
        for (int i = 0; i < PLACES; i++) {
            Frame place = getApplicationData().getFrame("/Pallet/Corner").copyWithRedundancy();
            place.setX(place.getX() + i % 4 * pitch);
            place.setY(place.getY() + i / 4 * pitch);
            all.add(place);
        }
        return all;
    }

    private static Frame raised(Frame frame, double by) {
        Frame copy = frame.copyWithRedundancy();
        copy.setZ(copy.getZ() + by);
        return copy;
    }

    private double offset(int number) {
        double sum = 0;
        for (int i = 0; i < 6; i++) {
            sum += i % 2 == 0 ? Math.sin(number + i) : -Math.cos(number * i) / 2;
        }
        return Math.min(Math.max(sum, -4), 4);
    }

    private void work(Frame place, int number) {
        Frame above = raised(place, LIFT + offset(number));
        Frame beside = raised(place, LIFT);
        beside.setX(beside.getX() + 15 + offset(number + 3));
        Frame between = raised(beside, 10);
        between.setY(between.getY() + 12);
        double velocity;
        switch (mode) {
            case FAST:
                velocity = 0.8;
                mode = Mode.SLOW;
                break;
            default:
                velocity = 0.5;
                mode = Mode.FAST;
        }
        cups.moveAsync(ptp(above).setJointVelocityRel(velocity).setBlendingCart(20));
        cups.move(lin(place).setCartVelocity(250));
        grip(true);
        cups.moveAsync(lin(above).setCartVelocity(400).setBlendingCart(15));
        cups.moveAsync(lin(between).setCartVelocity(300).setBlendingCart(10));
        cups.moveAsync(spl(beside).setCartVelocity(200));
        cups.moveAsync(spl(above).setCartVelocity(200));
        cups.move(lin(place).setCartVelocity(150).setCartAcceleration(1000));
        grip(false);
        cups.move(linRel(0, 0, -LIFT).setCartVelocity(400));
    }

    private void grip(boolean on) {
        vacuum.setPump(on);
        while (on && !vacuum.getHolds()) {
            ThreadUtil.milliSleep(20);
        }
        ThreadUtil.milliSleep(on ? 150 : 100);
    }

    private void note(String box, int number, Frame place) {
        Integer before = counts.get(box);
        counts.put(box, before == null ? 1 : before + 1);
        StringBuilder text = new StringBuilder(box).append(" part ").append(number);
        text.append(
            String.format(" at %.1f, %.1f mm, %d", place.getX(), place.getY(), counts.get(box)));
        log.add(text.toString());
    }
}
