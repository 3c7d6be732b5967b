package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class Spline extends SplineMotionCP<Spline> {
    public Spline(SplineMotionCP<?>... segments) {
        for (SplineMotionCP<?> segment : segments) {
            note("segment", segment);
        }
    }
}
