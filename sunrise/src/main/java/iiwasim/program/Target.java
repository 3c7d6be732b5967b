package iiwasim.program;

/** A target frame relative to the robot foot, with the redundancy data of the joints. */
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

    /** Pose relative to the robot foot. */
    public Pose pose() {
        return pose;
    }

    /** Position of joint A3, in rad; null if not given. */
    public Double e1Rad() {
        return e1Rad;
    }

    /** Sunrise status, 0 to 7; null if not given. */
    public Integer status() {
        return status;
    }

    /** Sunrise turn, 0 to 127; null if not given. */
    public Integer turn() {
        return turn;
    }

    /** Converts a target in {@code base} to the frame in which {@code base} is given. */
    Target in(Pose base) {
        return new Target(base.then(pose), e1Rad, status, turn);
    }
}
