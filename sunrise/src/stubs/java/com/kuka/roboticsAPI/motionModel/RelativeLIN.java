package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class RelativeLIN extends SplineMotionCP<RelativeLIN> {
    RelativeLIN(Object target) {
        note("to", target);
    }
}
