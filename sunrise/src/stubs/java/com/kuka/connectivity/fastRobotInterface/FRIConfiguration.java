package com.kuka.connectivity.fastRobotInterface;

import com.kuka.roboticsAPI.deviceModel.LBR;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class FRIConfiguration {
    public final String client;
    public int periodMs;
    public int multiplier;
    public int port;

    private FRIConfiguration(String client) {
        this.client = client;
    }

    public static FRIConfiguration createRemoteConfiguration(LBR robot, String client) {
        return new FRIConfiguration(client);
    }

    public void setSendPeriodMilliSec(int value) {
        periodMs = value;
    }

    public void setReceiveMultiplier(int value) {
        multiplier = value;
    }

    public void setPortOnRemote(int value) {
        port = value;
    }
}
