package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class SPL extends SplineMotionCP<SPL> {
    SPL(Object target) {
        note("to", target);
    }
}
