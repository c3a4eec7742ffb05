%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%
MODULE Part(SYSMODULE,NOSTEPIN)
  ! A half round, cut in one line and an arc.
  PERS tooldata tWheel:=[TRUE,[[0,0,250],[1,0,0,0]],[4.2,[0,0,110],[1,0,0,0],0.02,0.02,0.01]];
  TASK PERS wobjdata wPart:=[FALSE,TRUE,"",[[900,0,350],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];
  LOCAL CONST robtarget pStart:=[[0,-50,0],[0,1,0,0],[-1,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  LOCAL CONST robtarget pMid:=[[50,0,0],[0,1,0,0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]];
  CONST robtarget pSpare:=[[0,0,200],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST num nLift:=50;
  VAR speeddata vCut:=[20,500,5000,1000];
  PERS loaddata lPart:=[0.5,[0,0,50],[1,0,0,0],0,0,0];

  PROC main()
    ConfJ\Off;
    ConfL\Off;
    Approach;
    MoveL pStart,v100,z10,tWheel\WObj:=wPart;
    MoveL Offs(pStart,0,100,0),vCut,fine,tWheel\WObj:=wPart;
    MoveC pMid,pStart,v20,z1,tWheel\WObj:=wPart;
    WaitTime 0.5;
    SetDO doSpindle,0;
    ! Back along the tool.
    MoveL RelTool(pStart,0,0,-nLift\Rz:=0),v100,fine,tWheel\WObj:=wPart;
  ENDPROC

  PROC Approach()
    Set doVacuum;
    MoveJ Offs(pStart,0,0,nLift),v1000,fine,tWheel\WObj:=wPart;
    SetDO doSpindle,1;
  ENDPROC
ENDMODULE
