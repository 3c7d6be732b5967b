package com.kuka.roboticsAPI.deviceModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface JointLimits {
    JointPosition getMaxJointPosition();

    JointPosition getMinJointPosition();
}
