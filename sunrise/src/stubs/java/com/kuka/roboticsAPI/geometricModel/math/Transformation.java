package com.kuka.roboticsAPI.geometricModel.math;

import java.util.Arrays;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class Transformation {
    private final double[] values;

    private Transformation(double[] values) {
        this.values = values;
    }

    public static Transformation ofRad(double x, double y, double z, double a, double b, double c) {
        return new Transformation(new double[] {x, y, z, a, b, c});
    }

    @Override
    public String toString() {
        return Arrays.toString(values);
    }
}
