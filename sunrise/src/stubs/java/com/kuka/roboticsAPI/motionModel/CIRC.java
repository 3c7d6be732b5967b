package com.kuka.roboticsAPI.motionModel;

/** A stub of ours: see src/stubs/README.md. */
public class CIRC extends SplineMotionCP<CIRC> {
    CIRC(Object target) {
        note("to", target);
    }
}
