package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public abstract class SplineMotionCP<T extends SplineMotionCP<T>> extends RobotMotion<T> {
    public T setCartVelocity(double value) {
        return note("setCartVelocity", value);
    }

    public T setCartAcceleration(double value) {
        return note("setCartAcceleration", value);
    }

    public T setCartJerk(double value) {
        return note("setCartJerk", value);
    }

    public T setOrientationVelocity(double value) {
        return note("setOrientationVelocity", value);
    }

    public T setOrientationAcceleration(double value) {
        return note("setOrientationAcceleration", value);
    }

    public T setOrientationJerk(double value) {
        return note("setOrientationJerk", value);
    }

    public T setOrientationType(SplineOrientationType value) {
        return note("setOrientationType", value);
    }

    public T setOrientationReferenceSystem(OrientationReferenceSystem value) {
        return note("setOrientationReferenceSystem", value);
    }
}
