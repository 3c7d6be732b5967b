// package a;
/* class A { } */
