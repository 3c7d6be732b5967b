package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class CIRC extends SplineMotionCP<CIRC> {
    CIRC(Object target) {
        note("to", target);
    }
}
