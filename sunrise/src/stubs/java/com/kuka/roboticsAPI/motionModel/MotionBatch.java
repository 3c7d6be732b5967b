package com.kuka.roboticsAPI.motionModel;

/** A stub of ours: see src/stubs/README.md. */
public class MotionBatch extends RobotMotion<MotionBatch> {
    public MotionBatch(RobotMotion<?>... motions) {
        for (RobotMotion<?> motion : motions) {
            note("motion", motion);
        }
    }
}
