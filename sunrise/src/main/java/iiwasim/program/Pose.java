package iiwasim.program;

/** A position and an orientation: x, y, z in mm, and R = Rz(a) Ry(b) Rx(c). */
public final class Pose {
    public static final Pose IDENTITY = Pose.of(0, 0, 0, 0, 0, 0);

    private final double[] xyz;
    /** Rows of the rotation matrix. */
    private final double[][] rotation;

    private Pose(double[] xyz, double[][] rotation) {
        this.xyz = xyz;
        this.rotation = rotation;
    }

    /** A pose from lengths in mm and angles in rad. */
    public static Pose of(double x, double y, double z, double a, double b, double c) {
        double ca = Math.cos(a);
        double sa = Math.sin(a);
        double cb = Math.cos(b);
        double sb = Math.sin(b);
        double cc = Math.cos(c);
        double sc = Math.sin(c);
        return new Pose(new double[] {x, y, z}, new double[][] {
            {ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc},
            {sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc},
            {-sb, cb * sc, cb * cc},
        });
    }

    /** The composition of this pose with {@code next}, given in the frame of this pose. */
    public Pose then(Pose next) {
        double[] position = new double[3];
        double[][] product = new double[3][3];
        for (int i = 0; i < 3; i++) {
            position[i] = xyz[i];
            for (int k = 0; k < 3; k++) {
                position[i] += rotation[i][k] * next.xyz[k];
                for (int j = 0; j < 3; j++) {
                    product[i][j] += rotation[i][k] * next.rotation[k][j];
                }
            }
        }
        return new Pose(position, product);
    }

    /** The inverse pose. */
    public Pose inverse() {
        double[] position = new double[3];
        double[][] transposed = new double[3][3];
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++) {
                transposed[i][k] = rotation[k][i];
                position[i] -= rotation[k][i] * xyz[k];
            }
        }
        return new Pose(position, transposed);
    }

    /** x, y and z in mm. */
    public double[] xyzMm() {
        return xyz.clone();
    }

    /** a, b and c in rad. If b is 90 degrees, c is 0. */
    public double[] abcRad() {
        double cosB = Math.hypot(rotation[0][0], rotation[1][0]);
        double b = Math.atan2(0.0 - rotation[2][0], cosB);
        if (cosB < 1e-9) {
            return new double[] {Math.atan2(-rotation[0][1], rotation[1][1]), b, 0};
        }
        double a = Math.atan2(rotation[1][0], rotation[0][0]);
        return new double[] {a, b, Math.atan2(rotation[2][1], rotation[2][2])};
    }

    /** The distance between two origins, in mm. */
    public double distanceMm(Pose other) {
        double sum = 0;
        for (int i = 0; i < 3; i++) {
            sum += (xyz[i] - other.xyz[i]) * (xyz[i] - other.xyz[i]);
        }
        return Math.sqrt(sum);
    }

    /** The angle between two orientations, in rad. */
    public double angleRad(Pose other) {
        double[][] r = inverse().then(other).rotation;
        double sine = 0.5 * Math.sqrt(
            square(r[2][1] - r[1][2]) + square(r[0][2] - r[2][0]) + square(r[1][0] - r[0][1]));
        return Math.atan2(sine, 0.5 * (r[0][0] + r[1][1] + r[2][2] - 1));
    }

    private static double square(double value) {
        return value * value;
    }
}
