package com.kuka.connectivity.fastRobotInterface;

import com.kuka.roboticsAPI.motionModel.IMotionOverlay;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class FRIJointOverlay implements IMotionOverlay {
    public FRIJointOverlay(FRISession session, ClientCommandMode mode) {
    }

    @Override
    public String toString() {
        return "overlay";
    }
}
