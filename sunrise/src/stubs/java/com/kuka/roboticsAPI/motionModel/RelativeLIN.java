package com.kuka.roboticsAPI.motionModel;

/** A stub of ours: see src/stubs/README.md. */
public class RelativeLIN extends SplineMotionCP<RelativeLIN> {
    RelativeLIN(Object target) {
        note("to", target);
    }
}
