package iiwasim.program;

/** A frame to go to, in the robot's foot, and which joints reach it. */
public final class Target {
    private final Pose pose;
    private final Double e1Rad;
    private final Integer status;
    private final Integer turn;

    Target(Pose pose, Double e1Rad, Integer status, Integer turn) {
        this.pose = pose;
        this.e1Rad = e1Rad;
        this.status = status;
        this.turn = turn;
    }

    /** Where it is, in the robot's foot. */
    public Pose pose() {
        return pose;
    }

    /** The position of joint A3, in rad; null if it is not given. */
    public Double e1Rad() {
        return e1Rad;
    }

    /** Sunrise's status, 0 to 7; null if it is not given. */
    public Integer status() {
        return status;
    }

    /** Sunrise's turn, 0 to 127; null if it is not given. */
    public Integer turn() {
        return turn;
    }

    /** The same, in {@code base}. */
    Target in(Pose base) {
        return new Target(base.then(pose), e1Rad, status, turn);
    }
}
