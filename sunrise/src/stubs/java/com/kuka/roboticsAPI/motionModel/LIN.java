package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class LIN extends SplineMotionCP<LIN> {
    LIN(Object target) {
        note("to", target);
    }
}
