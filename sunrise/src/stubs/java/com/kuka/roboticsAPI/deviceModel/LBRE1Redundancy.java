package com.kuka.roboticsAPI.deviceModel;

/** Stub of the KUKA type: see src/stubs/README.md. */
public class LBRE1Redundancy {
    private Double e1;
    private Integer status;
    private Integer turn;

    public LBRE1Redundancy setE1(double value) {
        e1 = value;
        return this;
    }

    public LBRE1Redundancy setStatus(int value) {
        status = value;
        return this;
    }

    public LBRE1Redundancy setTurn(int value) {
        turn = value;
        return this;
    }

    @Override
    public String toString() {
        return "e1 " + e1 + " status " + status + " turn " + turn;
    }
}
