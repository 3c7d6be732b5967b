package com.kuka.roboticsAPI.motionModel;

/** A stub of ours: see src/stubs/README.md. */
public class PTP extends RobotMotion<PTP> {
    PTP(Object target) {
        note("to", target);
    }
}
