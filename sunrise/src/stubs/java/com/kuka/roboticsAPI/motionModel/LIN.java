package com.kuka.roboticsAPI.motionModel;

/** A stub of ours: see src/stubs/README.md. */
public class LIN extends SplineMotionCP<LIN> {
    LIN(Object target) {
        note("to", target);
    }
}
