package com.kuka.roboticsAPI.motionModel;

import java.util.Arrays;

/** Stub of the KUKA type: see src/stubs/README.md. */
public abstract class RobotMotion<T extends RobotMotion<T>> implements IMotion {
    /** The calls so far, for tests. */
    public final StringBuilder calls = new StringBuilder();

    @SuppressWarnings("unchecked")
    protected T note(String name, Object value) {
        String text = value instanceof double[] ? Arrays.toString((double[]) value)
            : String.valueOf(value);
        calls.append(' ').append(name).append('(').append(text).append(')');
        return (T) this;
    }

    public T setJointVelocityRel(double value) {
        return note("setJointVelocityRel", value);
    }

    public T setJointVelocityRel(double[] value) {
        return note("setJointVelocityRel", value);
    }

    public T setJointAccelerationRel(double value) {
        return note("setJointAccelerationRel", value);
    }

    public T setJointAccelerationRel(double[] value) {
        return note("setJointAccelerationRel", value);
    }

    public T setJointJerkRel(double value) {
        return note("setJointJerkRel", value);
    }

    public T setJointJerkRel(double[] value) {
        return note("setJointJerkRel", value);
    }

    public T setBlendingRel(double value) {
        return note("setBlendingRel", value);
    }

    public T setBlendingCart(double value) {
        return note("setBlendingCart", value);
    }

    public T setBlendingOri(double value) {
        return note("setBlendingOri", value);
    }

    @Override
    public String toString() {
        return getClass().getSimpleName() + calls;
    }
}
