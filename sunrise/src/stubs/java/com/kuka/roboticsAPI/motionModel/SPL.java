package com.kuka.roboticsAPI.motionModel;

/** A stub of ours: see src/stubs/README.md. */
public class SPL extends SplineMotionCP<SPL> {
    SPL(Object target) {
        note("to", target);
    }
}
