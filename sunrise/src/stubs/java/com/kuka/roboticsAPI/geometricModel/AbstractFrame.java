package com.kuka.roboticsAPI.geometricModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public interface AbstractFrame {
    double getX();

    double getY();

    double getZ();

    double getAlphaRad();

    double getBetaRad();

    double getGammaRad();
}
