package com.kuka.roboticsAPI.ioModel;

/** A stub of ours: see src/stubs/README.md. */
public enum IOTypes {
    BOOLEAN, INTEGER, UNSIGNED_INTEGER, ANALOG
}
