package com.kuka.roboticsAPI.motionModel;

/** A stub of ours: see src/stubs/README.md. */
public class CartesianPTP extends RobotMotion<CartesianPTP> {
    CartesianPTP(Object target) {
        note("to", target);
    }
}
