package com.kuka.roboticsAPI.motionModel;

/** A stub of ours: see src/stubs/README.md. */
public class Spline extends SplineMotionCP<Spline> {
    public Spline(SplineMotionCP<?>... segments) {
        for (SplineMotionCP<?> segment : segments) {
            note("segment", segment);
        }
    }
}
