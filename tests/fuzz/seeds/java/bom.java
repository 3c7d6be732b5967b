package application;

import static com.kuka.roboticsAPI.motionModel.BasicMotions.*;

import com.kuka.roboticsAPI.applicationModel.RoboticsAPIApplication;
import com.kuka.roboticsAPI.deviceModel.LBR;
import javax.inject.Inject;

public class Grüße extends RoboticsAPIApplication {
    @Inject
    private LBR lbr;

    @Override
    public void run() {
        double[] angles = {0.2, -0.2};
        for (double angle : angles) {
            lbr.moveAsync(ptp(angle, 0.5, 0, -1.4, 0, 1.2, 0).setBlendingRel(0.3));
        }
        if (lbr != null && angles.length > 1) {
            lbr.move(ptp(0, 0.5, 0, -1.4, 0, 1.2, 0).setJointVelocityRel(0.5));
        }
    }
}
