package com.kuka.roboticsAPI.motionModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public enum OrientationReferenceSystem {
    Base, Path
}
