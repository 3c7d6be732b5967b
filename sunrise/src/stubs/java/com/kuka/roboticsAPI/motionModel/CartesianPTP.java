package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class CartesianPTP extends RobotMotion<CartesianPTP> {
    CartesianPTP(Object target) {
        note("to", target);
    }
}
