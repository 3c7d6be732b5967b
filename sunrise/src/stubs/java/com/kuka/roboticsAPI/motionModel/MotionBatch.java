package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class MotionBatch extends RobotMotion<MotionBatch> {
    public MotionBatch(RobotMotion<?>... motions) {
        for (RobotMotion<?> motion : motions) {
            note("motion", motion);
        }
    }
}
