package com.kuka.roboticsAPI.geometricModel;

/** A stub of ours: see src/stubs/README.md. */
public interface AbstractFrame {
    double getX();

    double getY();

    double getZ();

    double getAlphaRad();

    double getBetaRad();

    double getGammaRad();
}
