package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class PTP extends RobotMotion<PTP> {
    PTP(Object target) {
        note("to", target);
    }
}
