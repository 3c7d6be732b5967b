package com.kuka.roboticsAPI.deviceModel;

/** A stub of ours: see src/stubs/README.md. */
public enum OperationMode {
    T1, T2, AUT
}
