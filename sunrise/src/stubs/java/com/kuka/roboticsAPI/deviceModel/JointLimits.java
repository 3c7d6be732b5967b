package com.kuka.roboticsAPI.deviceModel;

/** A stub of ours: see src/stubs/README.md. */
public interface JointLimits {
    JointPosition getMaxJointPosition();

    JointPosition getMinJointPosition();
}
