package com.kuka.roboticsAPI.motionModel;

import com.kuka.roboticsAPI.motionModel.controlModeModel.PositionControlMode;
import java.util.concurrent.TimeUnit;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class PositionHold extends RobotMotion<PositionHold> {
    public PositionHold(PositionControlMode mode, long time, TimeUnit unit) {
        note("for", time);
    }

    public PositionHold addMotionOverlay(IMotionOverlay overlay) {
        return note("addMotionOverlay", overlay);
    }
}
