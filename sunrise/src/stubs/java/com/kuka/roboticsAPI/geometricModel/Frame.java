package com.kuka.roboticsAPI.geometricModel;

import com.kuka.roboticsAPI.deviceModel.LBR;
import com.kuka.roboticsAPI.deviceModel.LBRE1Redundancy;
import java.util.Arrays;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class Frame implements AbstractFrame {
    private final double[] values;
    private LBRE1Redundancy redundancy;

    public Frame(AbstractFrame parent, double x, double y, double z, double a, double b, double c) {
        values = new double[] {x, y, z, a, b, c};
    }

    public void setRedundancyInformation(LBR robot, LBRE1Redundancy information) {
        redundancy = information;
    }

    @Override
    public double getX() {
        return values[0];
    }

    @Override
    public double getY() {
        return values[1];
    }

    @Override
    public double getZ() {
        return values[2];
    }

    @Override
    public double getAlphaRad() {
        return values[3];
    }

    @Override
    public double getBetaRad() {
        return values[4];
    }

    @Override
    public double getGammaRad() {
        return values[5];
    }

    @Override
    public String toString() {
        return Arrays.toString(values) + (redundancy == null ? "" : " " + redundancy);
    }
}
