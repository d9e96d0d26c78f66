%MATH471: Convergence with MMS
clear;close all;clc
%Error: test 1
n = [5 10 20 40 80 160];
n = n.^2;
error = [
    0.66631260214370269;
    3.40731237408417043E-002;
    8.92598114289569304E-003;
    1.85550587520385635E-003;
    4.18963690041942972E-004;
    9.97811317795268784E-005];
loglog(n,error,'-*')
set(gca,'fontsize',16)
