package com.kuka.connectivity.fastRobotInterface;

/** Stub of the KUKA type: see src/stubs/README.md. */
public enum ClientCommandMode {
    POSITION, WRENCH, TORQUE
}
